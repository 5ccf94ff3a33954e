"""Springs of any shape against closed formulas: rates, characteristics, and how rods represent the curved wire."""
