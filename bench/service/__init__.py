"""How fast the service is: uploads, downloads, many clients, and what it costs beside the stages themselves."""
