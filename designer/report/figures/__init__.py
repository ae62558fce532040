"""Every figure of the report: charts as vector graphics, scenes as bitmaps, one scene to turn.

What they show is computed in ``designer.analysis``; nothing here decides anything.
"""
