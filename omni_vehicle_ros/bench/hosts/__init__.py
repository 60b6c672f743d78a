"""Several hosts on one machine, on a network that loses, delays and breaks: what a vehicle spread over them does."""
