"""The figures of the thesis reproduced, and its claims judged.

``registry`` knows all figures; each says in ``needs`` what has to be computed for it, and ``reproduce`` does every such
task once. The modules beside are one a section of the thesis; ``claims/`` judges what it says about them.
"""
