"""The two-node elasto-plastic rod element of chapter 5.2: kinematics of the moving frame, and its UFL forms."""
