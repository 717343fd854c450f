param data: string = "cars.csv
let x = 3
