"""HTTP: routes, schemas, problem details. Loads no vision library."""
