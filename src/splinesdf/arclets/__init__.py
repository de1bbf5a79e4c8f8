"""Short, nearly straight arcs that a curve is cut into: their tree, curvature, joints and kinds."""
