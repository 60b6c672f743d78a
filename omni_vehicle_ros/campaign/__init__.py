"""Many short drives with random faults, each judged by what no fault may do."""
