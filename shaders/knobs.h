// Settings that kernels read as they are, as parameters.NAME: KNOB(type in a job, type here, name, default). From each row follow
// its member of RenderSettings (shared/job/render_settings.h), its member of FrameParameters in both languages, and what
// hands the one to the other. Its range and meaning stand in shared/job/fields.h.
#ifndef TILEFARM_KNOBS_H
#define TILEFARM_KNOBS_H

#define KERNEL_KNOBS(KNOB)                                                                        \
    KNOB(double, float, rouletteSurvival, 0.8) /* of the constant rule */                         \
    KNOB(uint32_t, uint, shadowDepth, 1024)    /* bounces after which shadow rays are skipped; biased below maxBounces */ \
    KNOB(double, float, regularisation, 0)     /* least α of surfaces behind a rough one; biased */

#endif
