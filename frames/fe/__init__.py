"""Shell finite elements: mesh, kinematics, stiffness and mass of a whole frame."""
