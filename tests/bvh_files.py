"""A small BVH file, for tests of what is read from it and of what is refused."""

__all__ = ["BVH"]

BVH = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Knee
  {
    OFFSET 0 -40 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 -45 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.01
0 90 0 1 2 3 4 5 6
0 90 1 1 2 3 4 5 6
0 90 2 1 2 3 4 5 6
"""
