"""Pictures of a run by MuJoCo: the scene, a video, a viewer."""
