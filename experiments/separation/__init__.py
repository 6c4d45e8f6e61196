"""How far apart two adjacent frames must stand: gaps, code rules, design equations and their regression."""
