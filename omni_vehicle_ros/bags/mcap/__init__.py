"""MCAP files: their records, read and written."""
