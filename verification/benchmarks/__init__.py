"""What coilset costs: time by stage, over the number of elements and ranks, and cases per hour (`coilset bench`)."""
