// A loop that hands samples to the monitors of watch.txt, and says what they say. Made with
//
//     ltlc build watch.txt --target c
//     gcc -std=c99 -O2 -ffp-contract=off -c watch.c
//     g++ -std=c++17 -O2 main.cpp watch.o -lm -o watch

#include "watch.hpp"

#include <chrono>
#include <cstdio>

using namespace std::chrono_literals;

namespace {

const char *text(watch::Verdict verdict)
{
    switch (verdict) {
    case watch::Verdict::not_started:
        return "not started";
    case watch::Verdict::violated:
        return "violated";
    case watch::Verdict::presumably_violated:
        return "presumably violated";
    case watch::Verdict::presumably_satisfied:
        return "presumably satisfied";
    case watch::Verdict::satisfied:
        return "satisfied";
    }
    return "";
}

// What every signal is at one moment of a drive towards a wall.
watch::Samples samples_at(watch::Time time)
{
    watch::Samples samples{};
    samples.speed = 1.0f;
    samples.has_speed = true;
    if (time % 50ms == 0ms && time < 800ms) { // the sonar is slower, and dies
        samples.distance = 1.0f - static_cast<float>(time.count()) * 1e-9f;
        samples.has_distance = true;
    }
    if (time == 0ms) {
        samples.mode = "DRIVE";
        samples.has_mode = true;
    }
    return samples;
}

} // namespace

int main()
{
    watch::Monitors monitors;
    monitors.begin(0ms);
    for (watch::Time now = 0ms; now <= 1200ms; now += 10ms) {
        const watch::Samples samples = samples_at(now);
        monitors.step(now, samples);
    }
    for (const watch::Property property : watch::properties) {
        std::printf("%s: %s since %lld ms, %u steps\n", watch::label(property).data(),
                    text(monitors.verdict(property)),
                    static_cast<long long>(monitors.since(property) / 1ms), monitors.steps(property));
    }
    if (const auto next = monitors.next_deadline()) {
        std::printf("next deadline at %lld ms\n", static_cast<long long>(*next / 1ms));
    }
    return 0;
}
