"""Random springs: what makers wind, pressed one after the other, and with fine references."""
