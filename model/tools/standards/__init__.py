"""Spring makers' knowledge: the formulas and tables of standards, standard wires, and warnings."""
