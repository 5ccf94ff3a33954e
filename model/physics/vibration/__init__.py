"""Small vibrations about an equilibrium: mass of the rod, natural frequencies and modes."""
