"""A small robot: a base on two driven wheels and two casters, which are its bumpers, with an arm of one joint."""

WHEELED = """
<mujoco model="cart">
  <compiler angle="radian"/>
  <default><geom solref="0.02 1" friction="1 0.005 0.0001"/></default>
  <worldbody>
    <body name="base" pos="0 0 0.1">
      <freejoint name="base"/>
      <geom name="hull" type="box" size="0.2 0.15 0.04" mass="8" contype="0" conaffinity="0"/>
      <geom name="front" type="sphere" size="0.05" pos="0.15 0 -0.05" mass="0.2" condim="1" priority="1"/>
      <geom name="back" type="sphere" size="0.05" pos="-0.15 0 -0.05" mass="0.2" condim="1" priority="1"/>
      <body name="left" pos="0 0.2 0">
        <joint name="left" axis="0 1 0"/>
        <geom name="left" type="sphere" size="0.1" mass="1"/>
      </body>
      <body name="right" pos="0 -0.2 0">
        <joint name="right" axis="0 1 0"/>
        <geom name="right" type="sphere" size="0.1" mass="1"/>
      </body>
      <body name="arm" pos="0 0 0.06">
        <joint name="arm" axis="0 1 0" range="-1.5 1.5" damping="0.5"/>
        <geom name="arm" type="capsule" size="0.02" fromto="0 0 0 0 0 0.3" mass="0.5" contype="0" conaffinity="0"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <velocity name="left" joint="left" kv="2"/>
    <velocity name="right" joint="right" kv="2"/>
    <position name="arm" joint="arm" kp="20"/>
  </actuator>
  <sensor><framepos name="base" objtype="body" objname="base"/></sensor>
</mujoco>
"""
