"""What a caller gives, checked: numbers, arrays, files; words for a name that is not known."""

from modrobust.checks.arguments import as_integer, as_number, as_truth
from modrobust.checks.arrays import as_array, as_indices, as_real, shape_error
from modrobust.checks.files import check_writable, replacing
from modrobust.checks.suggestions import did_you_mean, unknown_name

__all__ = [
    "as_array",
    "as_indices",
    "as_integer",
    "as_number",
    "as_real",
    "as_truth",
    "check_writable",
    "did_you_mean",
    "replacing",
    "shape_error",
    "unknown_name",
]
