"""Studies of many turns: grids and samples of a scenario on the batch physics, in tables and maps."""
