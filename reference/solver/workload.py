"""How much of a solution's work is done: its parts, weighted by their expected CPU seconds."""

from __future__ import annotations

from collections.abc import Mapping

from ..engines.plan import Report
from ..engines.registry import Background
from ..system.channel import ACTIVITY


class Workload:
    """Parts of a solution's work; each goes through the simulated time once.

    Args:
        report: called with the part of the whole work that is done, as simulated time in s.
        end_s: end of the simulated time.
        expected_s: expected CPU seconds of each part by what it does, such as "proving".
    """

    def __init__(
        self, report: Report | None, end_s: float, expected_s: Mapping[str, float]
    ) -> None:
        self._report = report
        self._end_s = end_s
        self._expected_s = dict(expected_s)
        self._reached_s = dict.fromkeys(expected_s, 0.0)
        self._begun: set[str] = set()
        self._background: dict[str, Background] = {}

    def part(self, activity: str) -> Report | None:
        """Return the progress callback of a part that this process works on; None if progress is not shown."""
        if self._report is None:
            return None

        def report(t: float) -> None:
            self._begun.add(activity)
            self._reached_s[activity] = max(float(t), self._reached_s[activity])
            self._tell()

        return report

    def watch(self, activity: str, work: Background) -> None:
        """Add the progress of a background process to that of the work, if both run at the same time."""
        if work.at_work:
            self._background[activity] = work

    def finish(self, activity: str) -> None:
        """Count a part as done, even if it has taken fewer steps than expected."""
        self._reached_s[activity] = self._end_s

    def _tell(self) -> None:
        """Report what is done, and say what is being done."""
        for activity, work in self._background.items():
            if work.finished:
                self.finish(activity)
            elif work.at_work:
                self._begun.add(activity)
                self._reached_s[activity] = max(work.reached, self._reached_s[activity])
        unfinished = [name for name in self._begun if self._reached_s[name] < self._end_s]
        if unfinished:
            order = list(self._expected_s)
            ACTIVITY.send(" and ".join(sorted(unfinished, key=order.index)))
        all_s = self._longest(dict.fromkeys(self._expected_s, 1.0))
        left_s = self._longest(
            {activity: 1 - t / self._end_s for activity, t in self._reached_s.items()}
        )
        assert self._report is not None
        self._report(self._end_s * (1 - left_s / all_s))

    def _longest(self, shares: Mapping[str, float]) -> float:
        """Return how long shares of the parts take, in expected seconds: those of the background beside the others."""
        here_s = 0.0
        longest_s = 0.0
        for activity, share in shares.items():
            part_s = share * self._expected_s[activity]
            if activity in self._background:
                longest_s = max(longest_s, part_s)
            else:
                here_s += part_s
        return max(here_s, longest_s)
