"""Training of policies by PPO with Stable-Baselines3."""
