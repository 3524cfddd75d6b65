"""Comparison of two scenarios: their data by key, their worlds by object, their texts by line and comment."""
