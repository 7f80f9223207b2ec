"""A robot drives towards a wall and brakes; a recording of its distance and speed is written."""

import json
import sys

parameters, recording = sys.argv[1:]
with open(parameters, encoding="utf-8") as file:
    given = json.load(file)
brake = {"dry": 3.0, "wet": 1.5}[given["floor"]]
distance, speed = 5.0, 0.0
with open(recording, "w", encoding="utf-8") as file:
    print("time,distance,speed", file=file)
    for tick in range(1000):
        print(f"{tick / 100},{distance:.6f},{speed:.6f}", file=file)
        wanted = given["cruise"] if distance > given["margin"] else 0.0
        speed = max(min(wanted, speed + 1.0 / 100), speed - brake / 100)
        distance -= speed / 100
