"""The wire's cross-section: quadrature of the disk, section resultants and section tangent."""
