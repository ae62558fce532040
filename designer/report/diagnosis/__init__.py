"""Sections of the diagnosis report: each turns a diagnosis into text, tables and figures."""
