"""Messages as columns, of any type and any size, and as tables in files."""
