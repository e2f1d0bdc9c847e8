"""URDF files: read strictly, reduced to a tree of joints and bodies, held against yourdfpy."""
