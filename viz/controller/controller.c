{% autoescape false %}
/* {{ title }}, written by spear-pin {{ version }}. See controller.h. */
#include "controller.h"

#include <math.h>
#include <string.h>

#define MOST_AT_ONCE 8 /* events of one call */

{{ helpers }}
{% for code in functions %}
{{ code }}
{% endfor %}
static const int watched[] = { {{ phases | map(attribute="watched") | join(", ") }} };
static const int event_of[][SPEAR_WATCHED] = {
{% for phase in phases %}
  { {{ phase.event_of | join(", ") }} }{{ "," if not loop.last }}
{% endfor %}
};
static const double tolerance[][SPEAR_WATCHED] = {
{% for phase in phases %}
  { {{ phase.tolerances | join(", ") }} }{{ "," if not loop.last }}
{% endfor %}
};
static const double limit[] = { {{ limits | join(", ") }} };

/* times of scheduled events since the phase began, in s */
static const int scheduled[] = { {{ phases | map(attribute="scheduled") | join(", ") }} };
static const double schedule[][{{ most_scheduled }}] = {
{% for phase in phases %}
  { {{ phase.schedule | join(", ") }} }{{ "," if not loop.last }}
{% endfor %}
};
static const int scheduled_event[] = { {{ phases | map(attribute="scheduled_event") | join(", ") }} };

static void law(const spear_controller *c, double t, const double *q, const double *v, double *u, double *values)
{
  const double clock = t - c->began;
  const double *arg[4];
  double *res[2];
  arg[0] = &clock; arg[1] = q; arg[2] = v; arg[3] = c->held;
  res[0] = u; res[1] = values;
  switch (c->phase) {
{% for phase in phases %}
  case SPEAR_{{ phase.name | upper }}: {{ phase.name }}_law(arg, res); break;
{% endfor %}
  default: break;
  }
}

void spear_torques(const spear_controller *c, double t, const double *q, const double *v, double *u)
{
  law(c, t, q, v, u, 0);
}

static void enter(spear_controller *c, int phase, double t)
{
  c->phase = phase;
  c->began = t;
  c->switches = 0;
  memset(c->armed, 0, sizeof c->armed);
}

void spear_init(spear_controller *c, int standing, double t, const double *q, const double *v)
{
  const double clock = 0.0;
  const double *arg[4];
  double *res[1];
  memset(c, 0, sizeof *c);
  arg[0] = &clock; arg[1] = q; arg[2] = v; arg[3] = c->held;
  res[0] = c->held;
  if (standing) {
    begin_standing(arg, res);
    enter(c, SPEAR_{{ begins_standing | upper }}, t);
  } else {
    begin_aloft(arg, res);
    enter(c, SPEAR_{{ begins_aloft | upper }}, t);
  }
}

int spear_event(spear_controller *c, int event, double t, const double *q, const double *v)
{
  const double clock = t - c->began;
  double next[SPEAR_HELD];
  const double *arg[4];
  double *res[1];
  int i, into = -1;
  memcpy(next, c->held, sizeof next);
  arg[0] = &clock; arg[1] = q; arg[2] = v; arg[3] = c->held;
  res[0] = next;
  switch (c->phase) {
{% for phase in phases %}
  case SPEAR_{{ phase.name | upper }}:
    switch (event) {
{% for event in phase.events %}
    case SPEAR_{{ event.name | upper }}: {{ phase.name }}_{{ event.name }}(arg, res);{{ " into = SPEAR_" ~ event.into | upper ~ ";" if event.into }} break;
{% endfor %}
    default: return 0;
    }
    break;
{% endfor %}
  default: return 0;
  }
  if (scheduled[c->phase] > 0 && event == scheduled_event[c->phase]) ++c->switches;
  for (i = 0; i < watched[c->phase]; ++i)
    if (event_of[c->phase][i] == event) c->armed[i] = 0;
  memcpy(c->held, next, sizeof next);
  if (into >= 0) enter(c, into, t);
  return 1;
}

/* Returns the first event that is due at these signals, and writes the torques. */
static int estimate(spear_controller *c, double t, const double *q, const double *v, double *u)
{
  double values[SPEAR_WATCHED];
  int i, found = SPEAR_NOTHING;
  law(c, t, q, v, u, values);
  if (c->switches < scheduled[c->phase] && t - c->began >= schedule[c->phase][c->switches])
    return scheduled_event[c->phase];
  for (i = 0; i < watched[c->phase]; ++i) {
    const double near = tolerance[c->phase][i] + c->threshold;
    if (values[i] > near) c->armed[i] = 1;
    else if (found == SPEAR_NOTHING && values[i] <= (c->armed[i] ? near : -near)) found = event_of[c->phase][i];
  }
  return found;
}

int spear_step(spear_controller *c, double t, const double *q, const double *v, double *u)
{
  int i, count, event, last = SPEAR_NOTHING, sound = fabs(t) < HUGE_VAL;
  for (i = 0; i < SPEAR_COORDINATES; ++i) sound = sound && fabs(q[i]) < HUGE_VAL && fabs(v[i]) < HUGE_VAL;
  for (count = 0; sound && count < MOST_AT_ONCE; ++count) {
    event = estimate(c, t, q, v, u);
    if (event == SPEAR_NOTHING) break;
    spear_event(c, event, t, q, v);
    last = event;
  }
  if (sound && count == MOST_AT_ONCE) spear_torques(c, t, q, v, u);
  sound = sound && t - c->began <= SPEAR_LONGEST;
  for (i = 0; sound && i < SPEAR_JOINTS; ++i) {
    sound = fabs(u[i]) < HUGE_VAL;
    u[i] = fmax(-limit[i], fmin(limit[i], u[i]));
  }
  if (sound) return last;
  for (i = 0; i < SPEAR_JOINTS; ++i) u[i] = 0.0;
  return SPEAR_STOPPED;
}
{% endautoescape %}
