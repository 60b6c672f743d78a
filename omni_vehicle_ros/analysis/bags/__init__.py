"""Reports on bags, one or several side by side."""
