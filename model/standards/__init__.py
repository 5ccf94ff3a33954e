"""What spring makers know: the formulas and tables of standards, their wires, and what they would warn of."""
