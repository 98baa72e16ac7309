// KHR_lights_punctual: point, spot and directional lights.
// LightRecord: position p, direction a, b = (cos inner, cos outer, range m).
#ifndef PUNCTUAL_GLSL
#define PUNCTUAL_GLSL

#include "light_sample.glsl"

// glTF's window that takes a light smoothly to zero at its range; 1 where there is none.
float rangeWindow(float distanceSquared, float range) {
    if (isinf(range)) return 1.0;
    float q = distanceSquared / (range * range);
    return clamp(1.0 - q * q, 0.0, 1.0);
}

// Falloff between the inner and the outer cone.
float spotFalloff(float cosAngle, float cosInner, float cosOuter) {
    if (cosAngle >= cosInner) return 1.0;
    if (cosAngle <= cosOuter) return 0.0;
    float t = (cosAngle - cosOuter) / (cosInner - cosOuter);
    return t * t;
}

bool samplePunctualLight(LightRecord light, float pmf, Surface s, inout LightSample l) {
    l.radiance = lightValue(light) / pmf;
    l.pdf = 0.0;
    l.infinite = light.type == LIGHT_DIRECTIONAL;
    if (l.infinite) {
        l.wi = -light.a;
        l.target = l.wi;
    } else {
        vec3 toLight = light.p - s.position;
        float distanceSquared = dot(toLight, toLight);
        if (!(distanceSquared > 0.0)) return false;
        l.wi = toLight * inversesqrt(distanceSquared);
        l.target = light.p;
        l.radiance *= rangeWindow(distanceSquared, light.b.z) / distanceSquared;
        if (light.type == LIGHT_SPOT) l.radiance *= spotFalloff(dot(-l.wi, light.a), light.b.x, light.b.y);
    }
    l.origin = offsetOrigin(s.position, s.positionError, s.geometricNormal, l.wi);
    return maxComponent(l.radiance) > 0.0;
}

#endif
