"""What makes sense of a damaged bag, in a new one."""
