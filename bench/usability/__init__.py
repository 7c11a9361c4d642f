"""How many actions and how much time eight questions of an inspector cost, in the gallery, the page and the report."""
