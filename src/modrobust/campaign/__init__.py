"""Many closed loops of one robot: a list of runs, their figures, and the worst case of each."""

from modrobust.campaign.campaign import Campaign, campaign
from modrobust.campaign.figures import Record
from modrobust.campaign.plan import Plan, Run

__all__ = ["Campaign", "Plan", "Record", "Run", "campaign"]
