"""A robot written in the formats of other engines: URDF and MJCF.

Both hold one point of the parameters; what they cannot hold is listed, in the file and for the
caller.
"""

from modrobust.describe.common import Exported
from modrobust.describe.mjcf import mjcf_text
from modrobust.describe.urdf import urdf_text

__all__ = ["Exported", "mjcf_text", "urdf_text"]
