"""Alembic migrations: the only way tables come into being."""
