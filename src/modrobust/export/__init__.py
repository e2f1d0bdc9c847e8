"""A robot written in the formats of other engines: `urdf.urdf_text` and `mjcf.mjcf_text`.

Both hold one point of the parameters; what they cannot hold is listed, in the file and for the
caller.
"""
