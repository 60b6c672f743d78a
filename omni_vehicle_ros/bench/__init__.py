"""Measurements of how fast this package is, beside what others need for the same."""

BENCHES = ('kernel', 'sweep', 'graph', 'realtime', 'bags')
"""Modules of this package, each with ``bench(progress) -> Result``, see `frame`; the order in which all are run."""
