"""Every figure of the report: charts as vector graphics, scenes as bitmaps, one scene to turn.

``maps`` computes, ``charts_*`` and ``*_scene`` draw; nothing here decides anything.
"""
