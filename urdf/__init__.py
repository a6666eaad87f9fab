"""URDF descriptions of the shipped robots."""
