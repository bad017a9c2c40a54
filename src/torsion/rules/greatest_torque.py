"""The verdict on motion over time: no coupling may carry more than the greatest torque that its maker allows."""

from torsion.analyses.transient.transient_motion import Transients
from torsion.findings import Results
from torsion.rules.judgement import spans_of
from torsion.rules.verdict_line import Check, Rule, verdict_of


class GreatestTorque(Rule):
    """The rule on every motion over time that was computed; a coupling without the rating is not judged."""

    def check(self, evidence: Results, settings: None) -> tuple[Check, ...]:
        """Of every coupling with a `max_torque`; modes that the samples do not resolve are added to its peak."""
        checks, each = [], evidence.need(Transients).each
        for found in each:
            what = f"greatest torque of the motion over time {found.name}".rstrip()
            doubt = "" if found.status == "ok" else found.status
            for number, part in enumerate(evidence.study.train.parts):
                limit = None if part.ratings is None else part.ratings.max_torque
                if limit is None:
                    continue
                peak = float(found.peak[spans_of(evidence.system, number)].max())
                verdict = verdict_of(peak <= limit, "maker")
                checks.append(
                    Check("transient", "T_Kmax", part.name, what, peak, limit, "N m", verdict, "maker", note=doubt)
                )
        return tuple(checks)
