"""Springs nested in each other: coaxial, between the same seats."""
