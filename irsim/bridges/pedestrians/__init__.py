"""Recorded pedestrians: files of the data sets ETH, UCY and TrajNet become scenarios that replay them."""
