"""The provider of Processing algorithms: plans and captures in models, in batches and from a terminal."""
