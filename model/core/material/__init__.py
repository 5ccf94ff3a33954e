"""The constitutive law: pure functions over arrays of points, usable without a mesh."""
