// KHR_lights_punctual: point, spot and directional lights.
#ifndef PUNCTUAL_GLSL
#define PUNCTUAL_GLSL

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

#endif
