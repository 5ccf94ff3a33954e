"""Cases to start from; `coilset examples` lists and copies them."""
