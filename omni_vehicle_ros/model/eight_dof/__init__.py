"""The vehicle with roll and wheel spin: 8 degrees of freedom (after Boada et al. 2005)."""
