"""The kinds of light, in the order in which kernels ask for them. generate.py makes of each row its includes and its cases in
choosing a point on a light, in the pdf of a light that a path meets, and in the one point that cheap integrators take it for;
on the host its number and, for shapes that emit, the call of its packer."""

from collections import namedtuple

Light = namedtuple("Light", "kinds feature file sample pdf centre packer", defaults=(None, None, None))
Light.__doc__ = """
kinds    the constants' names behind LIGHT_
feature  FEATURE_* without which there is none
file     of shaders/lights
sample   GLSL that writes the LightSample `l` of the LightRecord `light` and says whether light arrives; `pmf`: probability of the
         light; `bits`: random; `key`, `bounce`: of the path; `s`: the surface
pdf      GLSL of the solid-angle pdf, 1/sr, of sampling it from the point `from`, times `pmf`; `t`, `cosine`: where the path
         meets it; `throughVeil`: see emitterPdf. None: no path meets its surface
centre   GLSL as sample's that takes its middle. None: what sample gives for the middle of the random numbers
packer   function of worker/render/lights: a shape as such a light"""

LIGHTS = [
    Light(("ENVIRONMENT",), "ENVIRONMENT", "environment.glsl", "sampleEnvironmentLight(key, bounce, pmf, s, l)"),
    Light(("TRIANGLE",), "EMISSIVE_TRIANGLES", "triangle.glsl", "sampleTriangleLight(light, pmf, bits, s, l)",
          "pmf * triangleLightPdf(light, t, cosine)"),
    Light(("QUAD",), "QUAD_LIGHTS", "quad.glsl", "sampleQuadLight(light, pmf, bits, s, l)",
          "pmf * quadLightPdf(light, from, t)", "centreOfQuadLight(light, s, l)", "addQuadShape"),
    Light(("SPHERE",), "SPHERE_LIGHTS", "sphere.glsl", "sampleSphereLight(light, pmf, bits, s, l)",
          "throughVeil ? 0.0 : pmf * sphereLightPdf(light, from)", packer="addSphereShape"),
    Light(("SUN",), "SUN_LIGHTS", "sun.glsl", "sampleSunLight(light, pmf, bits, s, l)"),
    Light(("POINT", "SPOT", "DIRECTIONAL"), "PUNCTUAL_LIGHTS", "punctual.glsl", "samplePunctualLight(light, pmf, s, l)"),
]
